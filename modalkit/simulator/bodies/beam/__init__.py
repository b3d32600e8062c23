"""The simulator's beam: fine, uneven, with shear and rotary inertia, dry or in water."""
