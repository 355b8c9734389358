#include "voroform/metrics/particles.hpp"
