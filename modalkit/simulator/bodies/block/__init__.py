"""Bodies put together from blocks of solid bricks, given by matrices that CalculiX makes."""
