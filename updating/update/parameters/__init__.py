"""The parameters of an update, and fast models and sensitivities for them."""
