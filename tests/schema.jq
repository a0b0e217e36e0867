# fits(SCHEMA): whether a value is as the JSON schema says; an error for a keyword not known here:
# jq -e -L tests --slurpfile schema SCHEMA 'include "schema"; fits($schema[0])' FILE
def known: ["$defs", "$ref", "$schema", "additionalProperties", "anyOf", "const", "description",
    "enum", "items", "maxItems", "maximum", "minItems", "minLength", "minimum", "pattern",
    "properties", "required", "title", "type"];
def is($kind): if $kind == "integer" then type == "number" and . == floor else type == $kind end;
def fits($whole; $s): . as $value
    | (($s | keys) - known) as $unknown
    | if $unknown != [] then error("schema.jq does not know \($unknown)") else . end
    | ($s["$ref"] == null or fits($whole; $whole["$defs"][$s["$ref"] | ltrimstr("#/$defs/")]))
    and ($s.type == null or is($s.type))
    and (($s | has("const") | not) or . == $s.const)
    and ($s.enum == null or any($s.enum[]; . == $value))
    and ($s.anyOf == null or any($s.anyOf[]; . as $one | $value | fits($whole; $one)))
    and ($s.pattern == null or test($s.pattern))
    and ($s.minLength == null or length >= $s.minLength)
    and ($s.minimum == null or . >= $s.minimum)
    and ($s.maximum == null or . <= $s.maximum)
    and ($s.minItems == null or length >= $s.minItems)
    and ($s.maxItems == null or length <= $s.maxItems)
    and ($s.items == null or all(.[]; fits($whole; $s.items)))
    and (type != "object" or (
        (($s.required // []) - keys == [])
        and all(to_entries[]; (($s.properties // {})[.key] // $s.additionalProperties) as $own
            | $own == null or ($own != false and (.value | fits($whole; $own))))));
def fits($schema): fits($schema; $schema);
