"""Variables of MATLAB files of versions 5 to 7.2."""
