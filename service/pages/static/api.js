// Shows the OpenAPI document with Swagger UI. "validatorUrl: null" keeps it from asking another server.
SwaggerUIBundle({ url: "/openapi.json", dom_id: "#api", deepLinking: true, validatorUrl: null });
