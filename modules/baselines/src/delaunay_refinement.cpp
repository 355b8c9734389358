#include "voroform/baselines/delaunay_refinement.hpp"
