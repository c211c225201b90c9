"""The instance sets with what is proven of them, as a data set for others: made, described, loaded, asked, scored."""
