"""Mode shapes at test points and over the model, and their correlation."""
