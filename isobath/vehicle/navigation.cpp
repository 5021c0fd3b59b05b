#include <isobath/vehicle/navigation.hpp>
