#include "voroform/metrics/dual_tetrahedra.hpp"
