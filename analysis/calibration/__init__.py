"""Which geometry and friction fit the published numbers: `make calibrate`."""
