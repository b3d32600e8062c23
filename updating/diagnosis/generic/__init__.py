"""A cause in no library: fields of stiffness and mass, loss and gains, weighed as the library's causes are."""
