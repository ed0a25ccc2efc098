"""Newton, MuJoCo and Blender run the scenes of the cloth bench, in an environment of their own."""
