#include "voroform/metrics/surface_cvt.hpp"
