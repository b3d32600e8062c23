"""A cause without a name: fields of stiffness and mass, loss and gains, weighed as the library's causes are."""
