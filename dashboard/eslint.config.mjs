// What tsc does not see. prettier decides the layout.
import js from "@eslint/js";
import hooks from "eslint-plugin-react-hooks";
import { defineConfig, globalIgnores } from "eslint/config";
import typescript from "typescript-eslint";

export default defineConfig(
  globalIgnores(["dist/", "src/api_types.ts"]),
  js.configs.recommended,
  {
    files: ["**/*.{ts,tsx}"],
    extends: [typescript.configs.strictTypeChecked, hooks.configs["recommended-latest"]],
    languageOptions: { parserOptions: { projectService: true } },
    rules: {
      "@typescript-eslint/no-confusing-void-expression": ["error", { ignoreArrowShorthand: true }],
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      // What effects and memos depend on is chosen by its content, e.g. names joined to one text.
      "react-hooks/exhaustive-deps": "off",
      // With noUncheckedIndexedAccess, loops over arrays cannot do without.
      "@typescript-eslint/no-non-null-assertion": "off",
    },
  },
  {
    files: ["**/*.mjs"],
    rules: {
      "no-undef": "off", // runs partly in Node.js, partly in the browser
      "no-empty-pattern": "off", // Playwright reads which fixtures one needs from its parameters
    },
  },
);
