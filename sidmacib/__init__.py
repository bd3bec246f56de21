"""Models of interlocking masonry joints with several locks under torsion and shear."""

import lazy_loader

# Modules are imported when first used: solvers take longer to import than most models to run.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
