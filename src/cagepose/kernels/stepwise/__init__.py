"""The paper's method: travels and turns chosen by rules of geometry."""
