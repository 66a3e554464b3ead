"""`cagepose.run` by the paper's rules, whatever the default method is."""

from __future__ import annotations

from functools import partial

import cagepose

run = partial(cagepose.run, method="stepwise")
