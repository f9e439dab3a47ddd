// Holds nothing: its target compiles headers.hpp once for all tests with the same compile options.
