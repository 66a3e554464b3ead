"""``python -m cagepose`` is ``cagepose``."""

from cagepose.cli.app import main

raise SystemExit(main())
