#include "voroform/metrics/shape_quality.hpp"
