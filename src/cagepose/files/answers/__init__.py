"""Answers of `cagepose.questions` as people and programs read them: `lines` and `document` in a module a question."""
