"""How probable data are under a state of the model, nuisances integrated out.

A family: each kind of data (:mod:`frequency`, :mod:`damping`, :mod:`constants`, :mod:`phase`, :mod:`level`,
:mod:`trend`) is a :class:`~updating.likelihood.base.Quantity` with its residual, its noise, its nuisances and its
named doubts, and returns them as a block; :mod:`comparison` puts the blocks together and :mod:`gaussian` integrates the
nuisances out.
"""
