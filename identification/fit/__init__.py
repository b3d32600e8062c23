"""The maximum-likelihood fit of a modal model to FRFs, from candidate poles to what the data bear out."""
