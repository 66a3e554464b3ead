"""From a scene to a `Run`: cast, call a compiled method, name the result."""
