"""A cause in no library: fields of stiffness and mass, loss and gains, compared as the library's causes are."""
