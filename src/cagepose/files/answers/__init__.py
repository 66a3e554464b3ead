"""Answers of `cagepose.questions` as people read them: `lines` in a module a question."""
