#include "voroform/metrics/accuracy.hpp"
