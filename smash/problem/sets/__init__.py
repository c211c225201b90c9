"""Instance sets: the generators, the committed sets, the open instances."""
