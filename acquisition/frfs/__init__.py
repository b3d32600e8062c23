"""FRFs made of hits: estimators, spectra, what each hit adds to their errors, and what is done with FRFs."""
