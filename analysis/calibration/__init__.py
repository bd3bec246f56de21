"""The geometry and friction that fit the published numbers: `make calibrate`."""
