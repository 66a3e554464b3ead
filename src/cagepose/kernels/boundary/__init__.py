"""A body as its boundary: trimmed vertices, edges, circles and faces; where two boundaries meet, at rest and moving.

Features and their boxes: `features`, `tree`, `geometry` (both bodies at a pose), `refit`.
Pairs at a pose: `meetings` asks `meeting` (straight) and `circle_meeting`, with what they say in `met` and `touching`;
`reach`, `within`, `surfaces`, `far_sides`, `twins` tell which count, `groups` which are alternatives; `bend` and
`on_circle` how their gaps go on.
First contact: `first_meeting` asks `first_touch` (straight, with `along_motion`) and `circle_first` (curved, with
`circle_ahead`, `curve_beside`, `closing`); `kept_meetings` and `hollow_end` what it passes over; `kept` finds a pair
again after a motion.
The start: `overlap` asks `strands`, `cuts`, `dents` and `shells`. Covers: `solids`, `covered`.
"""
