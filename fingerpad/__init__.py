"""The main job: press, charge and slide a fingerpad, from a scene to tables and pictures."""
