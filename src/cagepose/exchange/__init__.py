"""Files of other programs: a scene as MJCF, URDF or STL, MJCF and URDF as a scene, and MuJoCo beside a run."""
