#include "stator/dictionary/data_type.hpp"

namespace stator::dictionary {

base::StaticText to_text(DataType type) {
  switch (type) {
    case DataType::boolean:
      return "BOOLEAN";
    case DataType::integer8:
      return "INTEGER8";
    case DataType::integer16:
      return "INTEGER16";
    case DataType::integer32:
      return "INTEGER32";
    case DataType::unsigned8:
      return "UNSIGNED8";
    case DataType::unsigned16:
      return "UNSIGNED16";
    case DataType::unsigned32:
      return "UNSIGNED32";
    case DataType::real32:
      return "REAL32";
    case DataType::visible_string:
      return "VISIBLE_STRING";
    case DataType::octet_string:
      return "OCTET_STRING";
    case DataType::domain:
      return "DOMAIN";
    case DataType::real64:
      return "REAL64";
    case DataType::integer64:
      return "INTEGER64";
    case DataType::unsigned64:
      return "UNSIGNED64";
  }
  return "?";
}

}  // namespace stator::dictionary
