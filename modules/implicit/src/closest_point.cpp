#include "voroform/implicit/closest_point.hpp"
