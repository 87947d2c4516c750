"""Newton's method, the steps of the loads, the loop over the two scales, stability, and transfer to other meshes."""
