# anholon_add_model(): generated code of a model as a CMake target.
