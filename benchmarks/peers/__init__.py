"""One papillary ridge in other programs: the same mesh, law, penalty and loads, solved by somebody else's code."""
