#include "voroform/baselines/cube_grid.hpp"
