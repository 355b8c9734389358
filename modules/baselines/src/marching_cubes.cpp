#include "voroform/baselines/marching_cubes.hpp"
