"""``python -m pushpressslide`` is ``pps``."""

from pushpressslide.cli import main

if __name__ == "__main__":
    main()
