"""Places of a circle beside points, planes, lines, round sides and circles, where their distance is stationary."""
