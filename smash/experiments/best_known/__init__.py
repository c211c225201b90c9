"""The list of best known costs of the open instances."""
