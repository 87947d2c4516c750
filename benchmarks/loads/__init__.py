"""How far the closed form holds over the loads of people."""
