// The source of the target that precompiles the headers of the unit tests.
