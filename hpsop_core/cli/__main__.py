"""``python -m hpsop_core.cli``: the command ``hpsop`` where it is not installed."""

from hpsop_core.cli.main import main

raise SystemExit(main())
