"""Many runs of one scene with numbers that vary, and what they say. Needs the extra ``study``, and says so."""

from cagepose.views.extra import require_study

require_study()
