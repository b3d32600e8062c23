"""Cases in which a diagnosis once failed, made anew on the rig."""
