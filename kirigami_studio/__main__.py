"""``python -m kirigami_studio``: the same as the ``kirigami-studio`` command."""

import sys

from kirigami_studio.cli import main

if __name__ == "__main__":
    sys.exit(main())
