"""How probable data are under a state of the model, nuisances integrated out."""
