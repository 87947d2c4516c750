"""Laws of contact: formulations of the normal and tangential conditions, friction, and the law of a ridge."""
