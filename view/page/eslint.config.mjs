import tseslint from "typescript-eslint";

export default tseslint.config(tseslint.configs.recommended, tseslint.configs.stylistic, {
  files: ["src/**/*.ts"],
  languageOptions: { parserOptions: { projectService: true } },
  rules: {
    "@typescript-eslint/no-floating-promises": "error",
    "@typescript-eslint/no-non-null-assertion": "off", // elements of index.html and places in arrays
    "one-var": ["error", "never"],
    eqeqeq: ["error", "always", { null: "ignore" }],
    "prefer-const": "error",
  },
});
