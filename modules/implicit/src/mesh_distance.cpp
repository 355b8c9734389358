#include "voroform/implicit/mesh_distance.hpp"
