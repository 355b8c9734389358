#include "voroform/mesh/read_mesh.hpp"
